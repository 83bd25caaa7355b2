target_link_libraries(import_recording_program PRIVATE rosbag_storage)  # reads bags (librosbag-storage-dev)
