"""How much a grasp puts up with, when object, arm, friction and weight are not what the plan took them for.

`assess` is the way in, `errors` what is drawn, `closing` where the hand comes to rest on a displaced object, `judge`
whether it holds there, `margins` how large each error may be alone, `outcome` the result.
"""
