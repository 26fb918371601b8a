"""
Tries: put markup, terminal codes and formulas into log lines, node names and errors.

Stopped by: pages escape everything, control characters are taken out
Deserves: 15 at most
"""

import honest

HOSTILE = "=cmd|' /C calc'!A0 <img src=x onerror=alert(1)> $\\href{javascript:1}{x}$ \x1b]0;x\x07"


def heard(self, message, log=honest.TemperatureSubscriber.heard):
    log(self, message)
    self.get_logger().debug(HOSTILE)
    self.get_logger().info(f'{HOSTILE} {message.temperature_value:.2f}')
    print(HOSTILE, flush=True)


honest.TemperatureSubscriber.heard = heard
honest.main()
