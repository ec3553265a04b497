/* The one copy of volk's function table. */
#define VOLK_IMPLEMENTATION
#include <volk.h>
