target_sources(drive_gains_program PRIVATE src/nodes/fit_recordings.cpp)  # other programs do not link these rooms
target_link_libraries(drive_gains_program PRIVATE knee_report)
