
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def accepts(corrida):
    (entradas,) = corrida.sent.values()
    calientes = [t for t, m in zip(entradas.times, entradas.messages) if celsius(m) > 30.0]
    avisos = [linea.time_s for linea in corrida.logged('WARN')]
    return avisos == calientes
