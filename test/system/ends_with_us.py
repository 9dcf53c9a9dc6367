"""Helper programs end with their test or bench, even if that is killed before it can stop them."""

# Prefix for the command of a subprocess.Popen, which it then executes.
ENDS_WITH_US = ("setpriv", "--pdeathsig", "KILL")
