# SPDX-License-Identifier: Apache-2.0
# Ceres as a shared library. The static one of the distribution is built for the lowest processor and
# holds Eigen's functions, as our objects do for this machine's: the linker keeps one of two equal
# names, by the order of objects, and with AVX a matrix allocated by the one was freed by the other,
# whose allocator differs. A shared library keeps its own functions (keep_eigen_inside.map).
find_package(Ceres REQUIRED)
if(NOT CMAKE_CROSSCOMPILING)  # the allocators are the same for the board
  find_library(MIXRIG_CERES_SHARED libceres.so REQUIRED)
  set_target_properties(Ceres::ceres PROPERTIES IMPORTED_LOCATION_RELEASE ${MIXRIG_CERES_SHARED})
endif()
