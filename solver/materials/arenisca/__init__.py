"""What the cap models Arenisca3 and Arenisca4 share: parameters, elasticity, hardening and the sub-steps."""
