/* LD_PRELOAD for scripts/attacks: while the file $KNEE_HUNG_DISK exists, whatever writes to files below $KNEE_HUNG_FOLDER, or makes,
   renames and removes them, does not come back: a disk that hangs. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static int isThere(const char* path) {
  const char* folder = getenv("KNEE_HUNG_FOLDER");
  return folder != NULL && path != NULL && strncmp(path, folder, strlen(folder)) == 0;
}
static void hang(void) {
  const char* flag = getenv("KNEE_HUNG_DISK");
  const struct timespec pause = {0, 20000000};
  while (flag != NULL && access(flag, F_OK) == 0)
    nanosleep(&pause, NULL);
}
static void hangFile(int file) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return;
  path[size] = 0;
  if (isThere(path)) hang();
}
#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int file, const void* data, size_t size) {
  hangFile(file);
  return REAL(write)(file, data, size);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  hangFile(file);
  return REAL(writev)(file, parts, count);
}
int fsync(int file) {
  hangFile(file);
  return REAL(fsync)(file);
}
int fdatasync(int file) {
  hangFile(file);
  return REAL(fdatasync)(file);
}
int rename(const char* from, const char* to) {
  if (isThere(to)) hang();
  return REAL(rename)(from, to);
}
int unlink(const char* path) {
  if (isThere(path)) hang();
  return REAL(unlink)(path);
}
static int openSlowly(int (*real)(const char*, int, ...), const char* path, int flags, mode_t mode) {
  if ((flags & O_CREAT) != 0 && isThere(path)) hang();
  return real(path, flags, mode);
}
int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(list, mode_t) : 0;
  va_end(list);
  return openSlowly(REAL(open), path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(list, mode_t) : 0;
  va_end(list);
  return openSlowly(REAL(open64), path, flags, mode);
}
