"""Explain failed checks: exceptions, unresponsive nodes, missing log lines, failed builds."""
