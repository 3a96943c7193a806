/* By hand with newlib's tanhf. */
#include <math.h>
#define ACTIVATION tanhf
#include "by_hand.h"
