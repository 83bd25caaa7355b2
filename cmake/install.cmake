catkin_add_env_hooks(50.loopback SHELLS sh DIRECTORY ${PROJECT_SOURCE_DIR}/cmake/env-hooks)
catkin_install_python(PROGRAMS src/nodes/identification_server src/nodes/identification_session src/nodes/operator_page
  src/nodes/operator_user src/nodes/play_movement src/nodes/show_rviz
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY config launch operator pages urdf DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
# The pages of reports, for programs of the devel space that are run without setup.bash, too.
file(MAKE_DIRECTORY ${CATKIN_DEVEL_PREFIX}/share/${PROJECT_NAME})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/pages ${CATKIN_DEVEL_PREFIX}/share/${PROJECT_NAME}/pages SYMBOLIC)

# Headers and libraries for packages that bring components of their own (test/downstream is one): targets knee_robot::ROOM, in the
# devel space as in the install space.
install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
set(exported_targets knee_robot_options rt_posix)
foreach(room ${knee_rooms})
  set_target_properties(knee_${room} PROPERTIES EXPORT_NAME ${room})
  list(APPEND exported_targets knee_${room})
endforeach()
install(TARGETS ${exported_targets} EXPORT ${PROJECT_NAME} ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
install(EXPORT ${PROJECT_NAME} NAMESPACE ${PROJECT_NAME}:: FILE ${PROJECT_NAME}-targets.cmake
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/cmake)
export(EXPORT ${PROJECT_NAME} NAMESPACE ${PROJECT_NAME}::
  FILE ${CATKIN_DEVEL_PREFIX}/share/${PROJECT_NAME}/cmake/${PROJECT_NAME}-targets.cmake)
