"""Programs that run beside a test or the bench, and end with it however it ends: it may be killed
before it can stop them."""

# Goes before the command of a subprocess.Popen, and becomes it.
ENDS_WITH_US = ("setpriv", "--pdeathsig", "KILL")
