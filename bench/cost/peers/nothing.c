/* No network: what the marks and the call cost, to be subtracted. */
void prepare(float *row) { (void)row; }
__attribute__((noinline)) float network(float x, float t) { (void)t; return x; }
