!> Energy, momentum and impacts of a bending wall (docs/theory/bending.md). Masses are over m_w.
module rwmf_model_bent_wall
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, frame_motion, model_t
   use rwmf_model_floor_motion, only: floor_motion
   implicit none
   private

   public :: bent_kinetic_energy, bent_gravity, bending_strain, landing, mean_acceleration
   public :: bent_overturning, bent_mass_matrix, solution

contains

   !> Kinetic energy of the wall and the linked frame or floors [J/kg].
   real(wp) function bent_kinetic_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u(0:max(1, equation%floors%n_storeys)), v(max(1, equation%floors%n_storeys))

      associate (beam => equation%beam, p => equation%p, q => y(equation%beam%first: &
                 equation%beam%first + equation%beam%n - 1), q_dot => y(equation%beam%first &
                 + equation%beam%n:equation%beam%first + 2*equation%beam%n - 1))
         energy = ((equation%inertia*p%R**2 - 2*equation%state%side*beam%half_width &
            *sum(beam%area*q) + sum(beam%mass*q**2))*y(2)**2 + sum(beam%mass*q_dot**2))/2 &
            + y(2)*sum(beam%arm*q_dot)
         if (allocated(beam%floors)) then
            call floor_motion(equation, equation%state%side, y, u, v)
            energy = energy + sum(beam%floors%m*v**2)/2
         else if (equation%has_frame) then
            call frame_motion(equation, equation%state%side, y, u(1), v(1))
            energy = energy + p%gamma*v(1)**2/2
         end if
      end associate
   end function bent_kinetic_energy

   !> Acceleration of the wall's centroid due to the modes, horizontal and vertical [m/s2].
   pure function mean_acceleration(equation, y, y_dot) result(a)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates
      real(wp) :: a(2)
      real(wp) :: across, along

      associate (area => equation%beam%area, n => equation%beam%n, first => equation%beam%first)
         associate (q => y(first:first + n - 1), q_dot => y(first + n:first + 2*n - 1), &
                    q_ddot => y_dot(first + n:first + 2*n - 1))
            across = sum(area*(q_ddot - q*y(2)**2))
            along = -sum(area*(2*q_dot*y(2) + q*y_dot(2)))
         end associate
      end associate
      a = [cos(y(1))*across + sin(y(1))*along, cos(y(1))*along - sin(y(1))*across]
   end function mean_acceleration

   !> Moment of the horizontal inertia of a bending wall about the ground over m_w [m2/s2].
   pure real(wp) function bent_overturning(equation, ground_acceleration, y, y_dot) result(moment)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: ground_acceleration
      !! [m/s2]
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates
      real(wp), dimension(equation%beam%n) :: push, height
      !! acceleration and height per deflection of each mode [1/s2], [-]
      real(wp) :: push_0, push_1, height_0, arm, sine, cosine
      !! acceleration on the straight axis, at the base [m/s2] and its increase [1/s2]; height

      associate (beam => equation%beam, n => equation%beam%n, first => equation%beam%first, &
                 b => equation%beam%half_width, length => equation%beam%length)
         associate (q => y(first:first + n - 1), q_dot => y(first + n:first + 2*n - 1), &
                    q_ddot => y_dot(first + n:first + 2*n - 1))
            sine = sin(y(1))
            cosine = cos(y(1))
            arm = equation%state%side*b
            push_0 = ground_acceleration + arm*(cosine*y(2)**2 + sine*y_dot(2))
            push_1 = cosine*y_dot(2) - sine*y(2)**2
            push = cosine*(q_ddot - q*y(2)**2) - sine*(2*q_dot*y(2) + q*y_dot(2))
            height_0 = arm*sine
            height = -sine*q
            moment = push_0*height_0 + (push_0*cosine + push_1*height_0)*length/2 &
               + push_1*cosine*length**2/3 + b**2/3*sine*(sine*y_dot(2) + cosine*y(2)**2) &
               + sum((push_0*height + push*height_0)*beam%area + (push_1*height + push*cosine) &
               *beam%arm + push*height*beam%mass)
         end associate
      end associate
   end function bent_overturning

   !> Potential energy of the weight due to the deflection of the wall [J/kg].
   real(wp) function bent_gravity(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (beam => equation%beam)
         energy = -equation%p%g*sin(y(1))*sum(beam%area*y(beam%first:beam%first + beam%n - 1))
      end associate
   end function bent_gravity

   !> Strain energy of the wall [J/kg].
   real(wp) function bending_strain(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (beam => equation%beam)
         energy = sum(beam%mass*(beam%omega*y(beam%first:beam%first + beam%n - 1))**2)/2
      end associate
   end function bending_strain

   !> Compute the velocities after an impact. The impulse acts at the new corner, so the momenta
   !> conjugate to the rotation about it and to each mode are conserved. With the coupling B of
   !> rotation and modes, the mass matrix M of the modes and C = B M**-1 B, the rotation continues
   !> with theta'+ = (H - C)/(I - C) theta'-. If this is not towards the new side, both corners stay
   !> on the base and the modes take all momentum.
   subroutine landing(equation, inertance, y, after, stays)
      type(equation_t), intent(in) :: equation
      !! equation on the side before the impact
      real(wp), intent(in) :: inertance
      !! inertance of the inerter under a corner over m_w [-]
      real(wp), intent(inout) :: y(:)
      !! (states) at theta = 0, with theta' before the impact; the modes change
      real(wp), intent(inout) :: after
      !! theta' after the impact [rad/s]
      logical, intent(inout) :: stays
      !! both corners stay on the base; on entry, regardless of the momentum
      real(wp), dimension(equation%beam%n) :: coupling, taken
      real(wp) :: matrix(0:equation%beam%n, 0:equation%beam%n)
      real(wp) :: lean, inertia, momentum, shared

      matrix = bent_mass_matrix(equation)
      associate (beam => equation%beam, n => equation%beam%n, b => equation%beam%half_width, &
                 q => y(equation%beam%first:equation%beam%first + equation%beam%n - 1))
         lean = equation%state%side*sum(beam%area*q)
         momentum = matrix(0, 0) - 2*b**2 + sum(beam%mass*q**2)
         ! the new corner is on the other side
         inertia = momentum + 2*b**2 + 2*b*lean + inertance*(2*b)**2
         coupling = matrix(1:, 0)
         taken = solution(matrix(1:, 1:), coupling)
         shared = dot_product(coupling, taken)
         after = (momentum - shared)/(inertia - shared)*y(2)
         if (.not. stays) stays = .not. (momentum - shared)*(inertia - shared) > 0
         if (stays) after = 0
         y(beam%first + n:beam%first + 2*n - 1) = y(beam%first + n:beam%first + 2*n - 1) &
            + taken*(y(2) - after)
      end associate
   end subroutine landing

   !> Mass matrix of rotation about a corner and modes, with the linked masses, of the straight wall
   !> on its base [m2], [m], [-].
   pure function bent_mass_matrix(model) result(mass)
      class(model_t), intent(in) :: model
      !! with `&bending`
      real(wp) :: mass(0:model%beam%n, 0:model%beam%n)
      !! the rotation comes before the modes
      integer :: i

      associate (beam => model%beam, gamma => model%p%gamma)
         mass(1:, 1:) = beam%linked_mass
         do i = 1, beam%n
            mass(i, i) = mass(i, i) + beam%mass(i)
         end do
         if (allocated(beam%floors)) then
            associate (floors => beam%floors)
               mass(0, 0) = beam%length**2*sum(floors%m*floors%share**2)
               mass(1:, 0) = beam%arm + beam%length*matmul(floors%m*floors%share, floors%phi)
            end associate
         else
            mass(0, 0) = beam%length**2*gamma
            mass(1:, 0) = beam%arm + beam%length*gamma
         end if
         mass(0, 0) = mass(0, 0) + model%inertia*model%p%R**2
      end associate
      mass(0, 1:) = mass(1:, 0)
   end function bent_mass_matrix

   !> Solve a symmetric, positive definite system by Cholesky factors.
   pure function solution(matrix, right) result(x)
      real(wp), intent(in) :: matrix(:, :)
      !! (n, n) in any units
      real(wp), intent(in) :: right(:)
      !! (n) in any units
      real(wp) :: x(size(right))
      real(wp) :: factor(size(right), size(right))
      integer :: j, k

      factor = matrix
      do j = 1, size(x)
         do k = 1, j - 1
            factor(k, j) = (factor(k, j) - dot_product(factor(:k - 1, k), factor(:k - 1, j))) &
               /factor(k, k)
         end do
         factor(j, j) = sqrt(factor(j, j) - sum(factor(:j - 1, j)**2))
      end do
      do j = 1, size(x)
         x(j) = (right(j) - dot_product(factor(:j - 1, j), x(:j - 1)))/factor(j, j)
      end do
      do j = size(x), 1, -1
         x(j) = (x(j) - dot_product(factor(j, j + 1:), x(j + 1:)))/factor(j, j)
      end do
   end function solution

end module rwmf_model_bent_wall
