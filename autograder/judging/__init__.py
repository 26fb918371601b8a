"""Turn a recording and an exam into verdicts, and explain failed checks with likely causes."""
