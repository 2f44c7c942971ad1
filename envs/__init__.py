"""Turns a floor plan into a simulated world, and wheel commands into sensor messages.

Importing this package registers its Gymnasium environments; MuJoCo is imported when one is made.
"""

from gymnasium.envs.registration import register

register(
    id="TurtleBot3Burger-v0",
    entry_point="envs.burger_env:BurgerEnv",
    max_episode_steps=18_000,  # 30 minutes of 0.1 s steps
)
register(
    id="BurgerExplore-v0",
    entry_point="envs.explore_env:ExploreEnv",
    max_episode_steps=6_000,  # 10 minutes
)
register(
    id="BurgerNavigate-v0",
    entry_point="envs.navigate_env:NavigateEnv",
    max_episode_steps=600,  # 1 minute
)
