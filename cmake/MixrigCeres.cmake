# SPDX-License-Identifier: Apache-2.0
# Builds Ceres as a shared library. The distribution's static one is built for the lowest processor
# and contains Eigen's functions, as our objects do for this machine's processor. The linker keeps
# one of two functions of the same name, by the order of objects: with AVX, a matrix allocated by
# one version would be freed by the other, whose allocator differs. A shared library keeps its own
# functions (keep_eigen_inside.map).
find_package(Ceres REQUIRED)
if(NOT CMAKE_CROSSCOMPILING)  # the allocators are the same for the board
  find_library(MIXRIG_CERES_SHARED libceres.so REQUIRED)
  set_target_properties(Ceres::ceres PROPERTIES IMPORTED_LOCATION_RELEASE ${MIXRIG_CERES_SHARED})
endif()
