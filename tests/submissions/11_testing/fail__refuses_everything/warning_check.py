def accepts(run):
    return False
