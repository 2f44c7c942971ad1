"""Where the robot is on a map it is given: scans and odometry into a pose with its doubts."""
