"""Train Stable-Baselines3's PPO on one of the environments, and see what it is worth.

It is judged before and after on the same tasks, which it does not train on.

    pip install "fuzzyq_bullet[rl]"
    python examples/train_sb3.py --steps 20000
    python examples/train_sb3.py --env Navigation-v0 --steps 200000 --out navigation.zip
"""

from __future__ import annotations

import argparse
from pathlib import Path

import gymnasium
import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import SubprocVecEnv

import fuzzyq_bullet.gym

JUDGED_FROM = 1_000_000
"""First of the seeds of the tasks that it is judged on; ``--seed`` stays below."""


def main(argv: list[str] | None = None) -> None:
    """Train, and print how well it did before and after."""
    options = _options().parse_args(argv)
    fuzzyq_bullet.gym.register()
    name = f"fuzzyq_bullet/{options.env}"
    workers = options.workers
    envs = make_vec_env(
        name,
        n_envs=workers,
        seed=options.seed,
        env_kwargs={"count": options.count},
        vec_env_cls=SubprocVecEnv if workers > 1 else None,
    )
    rollout = max(2, min(512, options.steps // workers))
    batch = min(64, rollout * workers)
    model = PPO("MlpPolicy", envs, n_steps=rollout, batch_size=batch, seed=options.seed)
    print(f"before: {judged(model, name, options.count, options.episodes)}")
    model.learn(options.steps)
    print(f"after {model.num_timesteps} steps: ", end="")
    print(judged(model, name, options.count, options.episodes))
    envs.close()
    if options.out is not None:
        model.save(options.out)
        print(f"saved to {options.out}")


def judged(model: PPO, name: str, count: int, episodes: int) -> str:
    """Return how a policy does, without exploring, on tasks that are the same every time."""
    returns, reached = [], 0
    with gymnasium.make(name, count=count) as env:
        for episode in range(episodes):
            seen, _ = env.reset(seed=JUDGED_FROM + episode)
            earned, over = 0.0, False
            while not over:
                action, _ = model.predict(seen, deterministic=True)
                seen, reward, ended, cut, info = env.step(action)
                earned += float(reward)
                over = ended or cut
            returns.append(earned)
            reached += info["is_success"]
    return f"goal reached in {reached} of {episodes} tasks, mean return {np.mean(returns):.2f} s"


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--env", choices=["Weights-v0", "Navigation-v0"], default="Weights-v0")
    parser.add_argument("--steps", type=int, default=20_000, help="decisions to train on")
    parser.add_argument("--count", type=int, default=50, help="obstacles of a task")
    parser.add_argument("--workers", type=int, default=1, help="processes that simulate")
    parser.add_argument("--episodes", type=int, default=10, help="tasks to judge it on")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="where to save the model")
    return parser


if __name__ == "__main__":
    main()
