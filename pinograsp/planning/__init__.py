"""The whole way, from a robot file and a scene file to verified grasps.

`session` is the planner that stays warm, with its `task_models`; `one_shot` a single plan with it, `single_grasps` the
search for some grasps at once, `attempt` what happens to one start, `outcomes` what became of all of them.
`own_configuration` is the check of a posture that the user gives, with contacts from `own_contacts`. `why` explains a
task without grasps: `misses` says what kept starts from one, `remedies` looks for changes, those of `relaxations`, that
help in short plans, `trials`.
"""
