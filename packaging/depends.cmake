# SPDX-License-Identifier: Apache-2.0
# Read by cpack: the packages of the libraries that the command is linked to, and of the plug-ins
# that it loads by name.
execute_process(COMMAND ${CPACK_MIXRIG_DEPENDS_COMMAND} ${CPACK_MIXRIG_BINARY}
                OUTPUT_VARIABLE linked OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "${linked}, gstreamer1.0-plugins-base, gstreamer1.0-plugins-good, gstreamer1.0-libav, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libgl1-mesa-dri, libegl-mesa0, udev, gstreamer1.0-nice, gstreamer1.0-plugins-bad")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "v4l-utils, gpiod, dfu-util, gstreamer1.0-plugins-ugly")
