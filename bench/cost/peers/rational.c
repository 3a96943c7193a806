/* By hand with tempco's activation. */
static inline float rational(float u)
{
    u = u < -3.0f ? -3.0f : u > 3.0f ? 3.0f : u;
    float square = u * u;
    return u * (27.0f + square) / (27.0f + 9.0f * square);
}
#define ACTIVATION rational
#include "by_hand.h"
