/* LD_PRELOAD for scripts/attacks: while the file $KNEE_NO_THREADS exists no thread can be begun, as where a limit of processes is reached. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*begin)(void*), void* argument) {
  const char* flag = getenv("KNEE_NO_THREADS");
  if (flag != NULL && access(flag, F_OK) == 0) return EAGAIN;
  return ((__typeof__(&pthread_create))dlsym(RTLD_NEXT, "pthread_create"))(thread, attributes, begin, argument);
}
