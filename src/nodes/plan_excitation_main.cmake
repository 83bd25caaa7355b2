target_sources(plan_excitation_program PRIVATE src/nodes/plan_chain_excitation.cpp src/nodes/plan_rest_excitation.cpp)  # other programs do not link these rooms
target_link_libraries(plan_excitation_program PRIVATE knee_excitation knee_identification)
