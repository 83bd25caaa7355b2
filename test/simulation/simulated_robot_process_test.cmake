# The test runs the program itself.
target_compile_definitions(${room}_${name} PRIVATE KNEE_SIMULATED_ROBOT="$<TARGET_FILE:simulated_robot_program>")
add_dependencies(${room}_${name} simulated_robot_program)
