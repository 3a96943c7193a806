"""The peers. Each trains from one random start after the other and tells the stopwatch every residual that it sees.

Limits on progress are tightened where there are any: the defaults end long before the noise is reached.
"""

import contextlib
import io

import numpy as np

from problem import HIDDEN, Network, bent_start, predictor, random_start, rms


def scipy_lm(problem, watch):
    """SciPy least_squares, lm (MINPACK)|scipy|analytic Jacobian, 1000 evaluations"""
    scipy(problem, watch, random_start, method="lm", max_nfev=1000)


def scipy_lm_bent(problem, watch):
    """SciPy least_squares, lm (MINPACK)|scipy|as above, but from starts like tempco's"""
    scipy(problem, watch, lambda random: bent_start(random, problem), method="lm", max_nfev=1000)


def scipy_trf(problem, watch):
    """SciPy least_squares, trf|scipy|analytic Jacobian, 300 evaluations"""
    scipy(problem, watch, random_start, method="trf", x_scale="jac", max_nfev=300)


def scipy(problem, watch, start, **settings):
    from scipy.optimize import least_squares

    network = Network(problem.x)

    def residual(weights):
        values = network.output(weights) - problem.y
        watch.saw(rms(values), lambda: predictor(weights.copy()))
        return values

    tight = dict(ftol=1e-15, xtol=1e-15, gtol=1e-15)
    for random in watch.restarts():
        least_squares(residual, start(random), network.jacobian, **tight, **settings)


def scikit_learn(problem, watch):
    """scikit-learn MLPRegressor, lbfgs|scikit-learn|tol 1e-16, 5000 iterations"""
    from sklearn.neural_network import MLPRegressor

    tight = dict(activation="tanh", alpha=0.0, tol=1e-16, max_iter=5000, max_fun=50_000)
    for random in watch.restarts():
        seed = int(random.integers(2**31))
        network = MLPRegressor(hidden_layer_sizes=(HIDDEN,), solver="lbfgs", random_state=seed, **tight)
        network.fit(problem.x, problem.y)
        watch.saw(rms(network.predict(problem.x) - problem.y), lambda: network.predict)


def torch_lm(problem, watch):
    """torch-levenberg-marquardt|torch-levenberg-marquardt|QR, default damping, 300 steps"""
    import torch
    from torch_levenberg_marquardt.training import LevenbergMarquardtModule

    torch.set_num_threads(1)
    torch.set_default_dtype(torch.float64)
    x, y = torch.from_numpy(problem.x), torch.from_numpy(problem.y)[:, None]
    for random in watch.restarts():
        net = torch.nn.Sequential(torch.nn.Linear(2, HIDDEN), torch.nn.Tanh(), torch.nn.Linear(HIDDEN, 1))
        start = torch.from_numpy(random_start(random))
        with torch.no_grad():
            net[0].weight.copy_(start[: 2 * HIDDEN].reshape(2, HIDDEN).T)
            net[0].bias.copy_(start[2 * HIDDEN : 3 * HIDDEN])
            net[2].weight.copy_(start[3 * HIDDEN : -1][None, :])
            net[2].bias.copy_(start[-1:])
        trainer = LevenbergMarquardtModule(net)
        for _ in range(300):
            before = torch_predictor(net)
            _, loss, stop, _ = trainer.training_step(x, y)
            # The loss is the one before the step.
            watch.saw(float(loss) ** 0.5, lambda: before)
            if stop:
                break
        after = torch_predictor(net)
        watch.saw(rms(after(problem.x) - problem.y), lambda: after)


def torch_predictor(net):
    inputs, thresholds, outputs, constant = (parameter.detach().numpy() for parameter in net.parameters())
    return predictor(np.concatenate([inputs.T.ravel(), thresholds, outputs.ravel(), constant]))


def pyrenn_lm(problem, watch):
    """pyrenn train_LM|pyrenn|300 iterations"""
    import pyrenn

    computed = pyrenn.calc_error

    def calc_error(net, data):
        error = computed(net, data)
        frozen = dict(net, w=net["w"].copy())
        residual = (error / len(problem.y)) ** 0.5 * float(np.ravel(net["normY"])[0])
        watch.saw(residual, lambda: lambda x: np.ravel(pyrenn.NNOut(x.T, frozen)))
        return error

    pyrenn.calc_error = calc_error
    for random in watch.restarts():
        np.random.seed(int(random.integers(2**31)))
        with contextlib.redirect_stdout(io.StringIO()):
            pyrenn.train_LM(problem.x.T, problem.y, pyrenn.CreateNN([2, HIDDEN, 1]), k_max=300)


ALL = [scipy_lm, scipy_lm_bent, scipy_trf, torch_lm, scikit_learn, pyrenn_lm]
