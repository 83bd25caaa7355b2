find_package(Simbody REQUIRED)
target_include_directories(dynamics_simbody_test SYSTEM PRIVATE ${Simbody_INCLUDE_DIR})
target_link_libraries(dynamics_simbody_test ${Simbody_LIBRARIES})
# Debian's Simbody is built with assertions on, and its inline classes have another layout without them.
target_compile_options(dynamics_simbody_test PRIVATE -UNDEBUG)
