// Lists of arguments that draw twice, which the check finds, and others that do not.
const Vector2d a(draws.uniform(0, 640), draws.uniform(0, 480));
const Vector2d b = a + Vector2d(draws.normal(), draws.normal());
place(world, draws.below(3), Vector3d{0, 0, draws.uniform(1, 2)});

const Vector2d c{draws.uniform(0, 640), draws.uniform(0, 480)};
const double x = draws.normal(), y = draws.normal();
for (int i = draws.below(3); i < 9; i += draws.below(3)) use(draws.normal());
use(draws.normal(), [&] { return draws.normal(); });
// f(draws.normal(), draws.normal())

double placed(RandomStream& stream, double low) {
  return f(direction(stream), distance(low, stream)) + g(direction(stream), low);
}
