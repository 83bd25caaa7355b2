# Simbody, the engine of the virtual plant and a peer of our dynamics: a library of its own, so that nothing else compiles or loads it.
# Programs and tests that include simulation/simbody_robot.h or simulation/virtual_*.h link knee_simbody. Without Simbody they are left out.
set(simbody_sources src/simulation/simbody_robot.cpp src/simulation/virtual_plant.cpp src/simulation/virtual_recording.cpp)
get_target_property(simulation_sources knee_simulation SOURCES)
list(TRANSFORM simbody_sources PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE simbody_paths)
list(REMOVE_ITEM simulation_sources ${simbody_paths})
set_target_properties(knee_simulation PROPERTIES SOURCES "${simulation_sources}")

find_package(Simbody QUIET)
if(NOT Simbody_FOUND)
  message(STATUS "Simbody is not installed: neither virtual_plant nor its tests are built (scripts/install_dependencies --developer)")
  return()
endif()
add_library(knee_simbody STATIC ${simbody_sources})
target_link_libraries(knee_simbody PUBLIC knee_simulation ${Simbody_LIBRARIES})
set_target_properties(knee_simbody PROPERTIES POSITION_INDEPENDENT_CODE ON)
# Debian's Simbody is built with assertions on, and its inline classes have another layout without them.
set_source_files_properties(src/simulation/simbody_robot.cpp PROPERTIES COMPILE_OPTIONS "-isystem;${Simbody_INCLUDE_DIR};-UNDEBUG")
