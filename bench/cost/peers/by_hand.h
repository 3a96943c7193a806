/* The 2-10-1 network as one would write it by hand. */
static const float *weights;
void prepare(float *row) { weights = row; }

__attribute__((noinline)) float network(float x, float t)
{
    const float *input = weights, *bias = weights + 20, *output = weights + 30;
    float sum = weights[40];
    for (int i = 0; i < 10; i++)
        sum += output[i] * ACTIVATION(bias[i] + input[2 * i] * x + input[2 * i + 1] * t);
    return sum;
}
