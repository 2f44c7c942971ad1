"""The filters of probabilistic robotics: a belief, a control and a measurement into a belief."""
