"""What all tests share."""

import signal

# Started in the background of a shell, Python inherits an ignored SIGINT, and no test of Ctrl-C could pass.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
