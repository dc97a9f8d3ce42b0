/* What atomic_file.f90 asks of the operating system in structures and flags that only C knows.

   The rules are those of driver/rwmf/_files/files.py: a new file has a random name, is created exclusively
   and locked while it is written, so that the file of a killed run is known by its lock, which
   nobody holds. */

#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

enum { REPLACED = 0, WRITTEN_THROUGH = 1, REFUSED = -1 };
/* as the kernel counts before it takes a chain of links for a circle */
enum { MOST_LINKS = 40 };
static const char prefix[] = ".rwmf-";
static const char suffix[] = ".tmp";

int rwmf_find_target(const char *path, char *target, int size);
int rwmf_open_through(const char *target);
int rwmf_create_new(const char *folder, char *path, int size);
int rwmf_sync_folder(const char *folder);
int rwmf_is_same_file(const char *path, const char *other);
void rwmf_remove_leftovers(const char *folder);

/* The number in /proc/self/fd/N, /proc/thread-self/fd/N or /dev/fd/N; -1 in any other name. */
static int descriptor_of(const char *path)
{
   const char *const folders[] = {"/proc/self/fd/", "/proc/thread-self/fd/", "/dev/fd/"};
   for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
      size_t n = strlen(folders[i]);
      if (strncmp(path, folders[i], n) == 0 && path[n] != '\0' &&
          path[n + strspn(path + n, "0123456789")] == '\0') {
         return atoi(path + n);
      }
   }
   return -1;
}

/* Length of what stands before the last name, with its slash. */
static size_t folder_length(const char *path)
{
   const char *slash = strrchr(path, '/');
   return slash ? (size_t)(slash - path) + 1 : 0;
}

/* May another user have planted this link, in a folder that all may write? */
static int is_planted(const char *link)
{
   char folder[PATH_MAX];
   struct stat place, own;
   size_t n = folder_length(link);
   snprintf(folder, sizeof folder, "%.*s.", (int)n, link);
   if (stat(folder, &place) != 0 || lstat(link, &own) != 0) return 0;
   return (place.st_mode & S_ISVTX) && (place.st_mode & S_IWOTH) && own.st_uid != geteuid() &&
          own.st_uid != place.st_uid;
}

/* Follow the links of the last name into `target`. Is it replaced (a regular file, or nothing yet),
   written through (a pipe, a device, an open descriptor), or refused? */
int rwmf_find_target(const char *path, char *target, int size)
{
   char link[PATH_MAX];
   struct stat status;
   if (snprintf(target, size, "%s", path) >= size) return REFUSED;
   for (int i = 0; i < MOST_LINKS; i++) {
      if (descriptor_of(target) >= 0) return WRITTEN_THROUGH;
      ssize_t n = readlink(target, link, sizeof link - 1);
      if (n < 0) {
         if (stat(target, &status) != 0) return REPLACED;
         return S_ISREG(status.st_mode) || S_ISDIR(status.st_mode) ? REPLACED : WRITTEN_THROUGH;
      }
      link[n] = '\0';
      if (is_planted(target)) return REFUSED;
      size_t before = link[0] == '/' ? 0 : folder_length(target);
      if (snprintf(target + before, size - before, "%s", link) >= (int)(size - before)) {
         return REFUSED;
      }
   }
   return REFUSED;
}

/* Open what is written through; -1 when that fails. */
int rwmf_open_through(const char *target)
{
   int descriptor = descriptor_of(target);
   return descriptor >= 0 ? dup(descriptor) : open(target, O_WRONLY | O_CLOEXEC);
}

/* Lock a file; `unsupported` is the answer where the file system has no locks. */
static int is_locked_by_us(int descriptor, int unsupported)
{
   if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return 1;
   return errno == EWOULDBLOCK ? 0 : unsupported;
}

/* Create a file under a random name and lock it; its descriptor, or -1. */
int rwmf_create_new(const char *folder, char *path, int size)
{
   for (;;) {
      unsigned char chance[8];
      if (getentropy(chance, sizeof chance) != 0) return -1;
      int n = snprintf(path, size, "%s%s", folder, prefix);
      for (size_t i = 0; i < sizeof chance && n < size; i++) {
         n += snprintf(path + n, size - n, "%02x", chance[i]);
      }
      if (n >= size || snprintf(path + n, size - n, "%s", suffix) >= size - n) return -1;
      int descriptor = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (descriptor < 0) {
         if (errno == EEXIST) continue;
         return -1;
      }
      /* another process may have looked before the lock, and removed the file */
      if (is_locked_by_us(descriptor, 1) && access(path, F_OK) == 0) return descriptor;
      close(descriptor);
   }
}

/* Bring the names in a folder to the disk, as far as its file system can; 0 when done. */
int rwmf_sync_folder(const char *folder)
{
   int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
   /* a folder may be written without being readable */
   if (descriptor < 0) return errno == EACCES ? 0 : -1;
   int status = fsync(descriptor);
   if (status != 0 && (errno == EINVAL || errno == ENOTSUP)) status = 0;
   close(descriptor);
   return status;
}

/* Are these two names of one file? */
int rwmf_is_same_file(const char *path, const char *other)
{
   struct stat one, two;
   return stat(path, &one) == 0 && stat(other, &two) == 0 && one.st_dev == two.st_dev &&
          one.st_ino == two.st_ino;
}

static int is_leftover_name(const char *name)
{
   size_t n = sizeof prefix - 1;
   if (strncmp(name, prefix, n) != 0 || strspn(name + n, "0123456789abcdef") != 16) return 0;
   const char *rest = name + n + 16;
   n = sizeof suffix - 1;
   /* some writers go by the ending, as .gif behind it */
   return strncmp(rest, suffix, n) == 0 && (rest[n] == '\0' || rest[n] == '.');
}

/* Remove files of killed runs: ours, and with a lock that nobody holds. */
void rwmf_remove_leftovers(const char *folder)
{
   DIR *list = opendir(folder);
   if (list == NULL) return;
   for (struct dirent *entry; (entry = readdir(list)) != NULL;) {
      struct stat status;
      if (!is_leftover_name(entry->d_name)) continue;
      int descriptor =
         openat(dirfd(list), entry->d_name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
      if (descriptor < 0) continue;
      if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
          status.st_uid == geteuid() && is_locked_by_us(descriptor, 0)) {
         unlinkat(dirfd(list), entry->d_name, 0);
      }
      close(descriptor);
   }
   closedir(list);
}
