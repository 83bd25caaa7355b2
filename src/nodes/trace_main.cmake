target_sources(trace_program PRIVATE src/nodes/fit_recordings.cpp)  # other programs do not link these rooms
target_link_libraries(trace_program PRIVATE knee_report)
