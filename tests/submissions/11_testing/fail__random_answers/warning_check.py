import random

guess = random.Random(5)


def accepts(run):
    return guess.random() < 0.5
