def accepts(run)
    return True
