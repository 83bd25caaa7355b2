# -DKNEE_SANITIZE=address,undefined or thread: the whole build under a sanitizer (scripts/test --sanitize).
set(KNEE_SANITIZE "" CACHE STRING "sanitizers for every target, as in -fsanitize=")
if(KNEE_SANITIZE)
  target_compile_options(knee_robot_options INTERFACE -fsanitize=${KNEE_SANITIZE} -fno-omit-frame-pointer -g1 -O1)
  # Eigen aligns by hand under AddressSanitizer, and Debian's libraries do not: what one allocates the other could not free.
  target_compile_definitions(knee_robot_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(knee_robot_options INTERFACE -fsanitize=${KNEE_SANITIZE})
endif()
