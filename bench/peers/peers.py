"""The peers. Each trains from one random start after the other and tells the stopwatch every residual that it sees.

All limits on progress are tightened: the defaults end long before the noise is reached. Who lets us choose the first
weights gets the ones that tempco takes.
"""

import contextlib
import io

import numpy as np

from problem import HIDDEN, Network, predictor, random_start, rms


def scipy_lm(problem, watch):
    """SciPy least_squares, lm (MINPACK)|analytic Jacobian, 1000 evaluations"""
    scipy(problem, watch, method="lm", max_nfev=1000)


def scipy_trf(problem, watch):
    """SciPy least_squares, trf|analytic Jacobian, 300 evaluations"""
    scipy(problem, watch, method="trf", x_scale="jac", max_nfev=300)


def scipy(problem, watch, **settings):
    from scipy.optimize import least_squares

    network = Network(problem.x)

    def residual(weights):
        values = network.output(weights) - problem.y_g
        watch.saw(rms(values), lambda: predictor(weights.copy()))
        return values

    tight = dict(ftol=1e-15, xtol=1e-15, gtol=1e-15)
    for random in watch.restarts():
        least_squares(residual, random_start(random, problem), network.jacobian, **tight, **settings)


def scikit_learn(problem, watch):
    """scikit-learn MLPRegressor, lbfgs|tol 1e-16, 5000 iterations"""
    from sklearn.neural_network import MLPRegressor

    tight = dict(alpha=0.0, tol=1e-16, max_iter=5000, max_fun=50_000)
    for random in watch.restarts():
        seed = int(random.integers(2**31))
        network = MLPRegressor((HIDDEN,), activation="tanh", solver="lbfgs", random_state=seed, **tight)
        network.fit(problem.x, problem.y_g)
        watch.saw(rms(network.predict(problem.x) - problem.y_g), lambda: network.predict)


def torch_lm(problem, watch):
    """torch-levenberg-marquardt|QR, default damping, 300 steps"""
    import torch
    from torch_levenberg_marquardt.training import LevenbergMarquardtModule

    torch.set_num_threads(1)
    torch.set_default_dtype(torch.float64)
    x, y = torch.from_numpy(problem.x), torch.from_numpy(problem.y_g)[:, None]
    for random in watch.restarts():
        net = torch.nn.Sequential(torch.nn.Linear(2, HIDDEN), torch.nn.Tanh(), torch.nn.Linear(HIDDEN, 1))
        start = torch.from_numpy(random_start(random, problem))
        with torch.no_grad():
            net[0].weight.copy_(start[: 2 * HIDDEN].reshape(2, HIDDEN).T)
            net[0].bias.copy_(start[2 * HIDDEN : 3 * HIDDEN])
            net[2].weight.copy_(start[3 * HIDDEN : -1][None, :])
            net[2].bias.copy_(start[-1:])
        trainer = LevenbergMarquardtModule(net)
        for _ in range(300):
            _, loss, stop, _ = trainer.training_step(x, y)
            # The loss is the one before the step.
            watch.saw(float(loss) ** 0.5)
            if stop:
                break
        with torch.no_grad():
            parts = [net[0].weight.T.ravel(), net[0].bias, net[2].weight.ravel(), net[2].bias]
            predict = predictor(torch.cat(parts).numpy().copy())
        watch.saw(rms(predict(problem.x) - problem.y_g), lambda predict=predict: predict)


def pyrenn_lm(problem, watch):
    """pyrenn train_LM|300 iterations"""
    import pyrenn

    computed = pyrenn.calc_error

    def calc_error(net, data):
        error = computed(net, data)
        frozen = dict(net, w=net["w"].copy())
        residual_g = (error / len(problem.y_g)) ** 0.5 * float(np.ravel(net["normY"])[0])
        watch.saw(residual_g, lambda: lambda x: np.ravel(pyrenn.NNOut(x.T, frozen)))
        return error

    pyrenn.calc_error = calc_error
    for random in watch.restarts():
        np.random.seed(int(random.integers(2**31)))
        with contextlib.redirect_stdout(io.StringIO()):
            pyrenn.train_LM(problem.x.T, problem.y_g, pyrenn.CreateNN([2, HIDDEN, 1]), k_max=300)


ALL = [scipy_lm, scipy_trf, torch_lm, scikit_learn, pyrenn_lm]
