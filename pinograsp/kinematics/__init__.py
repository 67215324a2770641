"""The robot: URDF as Pinocchio gets it, model with arm, hand and pads, poses, contact points, postures of the hand."""
