document.body.append("hello")
