# Precompiled headers: reading Eigen, gtest or ROS costs about a second a source file, which is half of what most files take.
# Four of them, shared by every target that is compiled with the same flags:
#   knee_precompiled_room      Eigen, without what mechanism/decompositions compiles once, for the rooms' libraries (position independent)
#   knee_precompiled_fast_room the same for those that are optimized more
#   knee_precompiled_program   ROS and Eigen, for src/nodes
#   knee_precompiled_test      gtest and Eigen, for the tests
# -DKNEE_PRECOMPILED=OFF shows the includes that a source forgot.
option(KNEE_PRECOMPILED "precompiled headers" ON)
set(knee_standard_headers <algorithm> <array> <atomic> <cmath> <cstdint> <functional> <limits> <map> <memory>
  <optional> <string> <vector>)

# knee_precompiled(KIND LIBRARY... HEADERS HEADER...): the library knee_precompiled_KIND of nothing but the header. Where the linked
# libraries are only needed for their folders they are linked too: flags must equal those of the users.
function(knee_precompiled kind)
  cmake_parse_arguments(given "POSITION_INDEPENDENT" "" "LIBRARIES;HEADERS" ${ARGN})
  add_library(knee_precompiled_${kind} OBJECT ${PROJECT_SOURCE_DIR}/cmake/empty.cpp)
  target_link_libraries(knee_precompiled_${kind} PRIVATE knee_robot_options ${given_LIBRARIES})
  if(given_POSITION_INDEPENDENT)
    set_target_properties(knee_precompiled_${kind} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_precompile_headers(knee_precompiled_${kind} PRIVATE ${knee_standard_headers} ${given_HEADERS})
endfunction()

function(knee_use_precompiled target kind)
  if(KNEE_PRECOMPILED AND TARGET knee_precompiled_${kind})
    target_precompile_headers(${target} REUSE_FROM knee_precompiled_${kind})
  endif()
endfunction()

set(knee_fast $<$<CONFIG:Release>:-O3>)
if(KNEE_PRECOMPILED)
  foreach(kind room fast_room)
    knee_precompiled(${kind} POSITION_INDEPENDENT LIBRARIES Eigen3::Eigen HEADERS <Eigen/Dense>
      ${PROJECT_SOURCE_DIR}/include/knee_robot/mechanism/decompositions.h)
  endforeach()
  target_compile_options(knee_precompiled_fast_room PRIVATE ${knee_fast})
endif()
