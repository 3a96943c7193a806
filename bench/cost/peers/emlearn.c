/* emlearn's network of layers, as its generator writes it. */
#include <eml_net.h>

static float hidden_weights[20], hidden_biases[10], output_weights[10], output_bias[1], one[10], other[10];
static const EmlNetLayer layers[2] = {
    {10, 2, hidden_weights, hidden_biases, EmlNetActivationTanh},
    {1, 10, output_weights, output_bias, EmlNetActivationIdentity},
};
static EmlNet net = {2, layers, one, other, 10};

void prepare(float *row)
{
    for (int i = 0; i < 10; i++) {
        /* emlearn keeps weights input by input. */
        hidden_weights[i] = row[2 * i];
        hidden_weights[10 + i] = row[2 * i + 1];
        hidden_biases[i] = row[20 + i];
        output_weights[i] = row[30 + i];
    }
    output_bias[0] = row[40];
}

__attribute__((noinline)) float network(float x, float t)
{
    float features[2] = {x, t}, out[1] = {0};
    eml_net_regress(&net, features, 2, out, 1);
    return out[0];
}
