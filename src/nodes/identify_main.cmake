target_sources(identify_program PRIVATE src/nodes/fit_recordings.cpp)  # other programs do not link these rooms
target_link_libraries(identify_program PRIVATE knee_report)
