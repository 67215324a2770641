"""The whole way, from a robot file and a scene file to verified grasps."""

from .one_shot import DEFAULT_STARTS, Progress, plan

__all__ = ["DEFAULT_STARTS", "Progress", "plan"]
