# SPDX-License-Identifier: Apache-2.0
# Studio -> take: a target of its own, so that only it and the app know both.
if(TARGET mixrig_studio AND TARGET mixrig_take AND NOT TARGET mixrig_studio_take)
  find_package(nlohmann_json REQUIRED)
  mixrig_room(studio_take
    SOURCES glb_writer.cpp studio_take.cpp
    LINKS mixrig::base mixrig::studio mixrig::take
    PRIVATE_LINKS mixrig::image_io nlohmann_json::nlohmann_json)
endif()
