"""Turns a floor plan into a simulated world, and wheel commands into sensor messages.

Importing this package registers its Gymnasium environments; MuJoCo is imported when one is made.
"""

from gymnasium.envs.registration import register

register(
    id="TurtleBot3Burger-v0",
    entry_point="envs.burger_env:BurgerEnv",
    max_episode_steps=18_000,  # 30 minutes of 0.1 s steps
)
