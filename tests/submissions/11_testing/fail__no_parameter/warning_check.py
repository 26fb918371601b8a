def accepts():
    return True
