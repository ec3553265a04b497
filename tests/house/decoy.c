/* A library that lies in the current folder under another library's name. Where it gets loaded, it leaves a mark. */
#include <fcntl.h>

__attribute__((constructor)) static void leave_a_mark(void) {
  (void)!open("a-decoy-was-loaded", O_WRONLY | O_CREAT, 0600);
}
