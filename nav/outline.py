"""The robot's outline on the floor: its plates and its wheels, as two rectangles about the axle."""

Rectangle = tuple[float, float, float]
"""How far it reaches ahead of the axle, behind it and to each side [m]."""

BURGER_OUTLINE: tuple[Rectangle, Rectangle] = ((0.038, 0.102, 0.070), (0.033, 0.033, 0.089))
"""The collision box and the wheels' outer faces (turtlebot3_burger.urdf@da785b7)."""
