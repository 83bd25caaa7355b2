catkin_add_env_hooks(50.loopback SHELLS sh DIRECTORY ${CMAKE_SOURCE_DIR}/cmake/env-hooks)
catkin_install_python(PROGRAMS src/nodes/identification_server src/nodes/identification_session src/nodes/operator_page
  src/nodes/operator_user src/nodes/play_movement src/nodes/show_rviz
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY config launch operator urdf DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
