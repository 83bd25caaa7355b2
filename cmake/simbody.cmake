# Simbody, the engine of the virtual plant and a peer of our dynamics: programs and tests that use simulation/simbody_robot.h
# link knee_simbody. The room's library is compiled against it but does not pull it into other programs.
find_package(Simbody REQUIRED)
add_library(knee_simbody INTERFACE)
target_link_libraries(knee_simbody INTERFACE knee_simulation ${Simbody_LIBRARIES})
set_source_files_properties(${CMAKE_SOURCE_DIR}/src/simulation/simbody_robot.cpp PROPERTIES
  # Debian's Simbody is built with assertions on, and its inline classes have another layout without them.
  COMPILE_OPTIONS "-isystem;${Simbody_INCLUDE_DIR};-UNDEBUG")
