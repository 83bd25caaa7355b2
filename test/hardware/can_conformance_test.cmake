# A program of its own: the cases are in conformance.h, and another source of this room has them too.
target_link_libraries(hardware_can_conformance_test knee_simulation)
