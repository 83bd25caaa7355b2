set_source_files_properties(src/nodes/plan_chain_excitation.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # other programs do not link these rooms
target_link_libraries(plan_excitation_program PRIVATE knee_excitation knee_identification)
