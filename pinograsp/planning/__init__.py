"""The whole way, from a robot file and a scene file to verified grasps.

`session` is the planner that stays warm, `one_shot` a single plan with it, `attempt` what happens to one start,
`outcomes` what became of all of them, `own_configuration` the check of a posture that the user gives.
"""
