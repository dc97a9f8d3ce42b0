!> Energy and impacts of a wall that bends (docs/theory/bending.md). Masses are over m_w.
module rwmf_model_bent_wall
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, frame_motion
   use rwmf_model_kinematics, only: kinematics_of, kinematics_t
   implicit none
   private

   public :: bent_kinetic_energy, bent_frame_strain, bent_gravity, bending_strain, landing
   public :: linked_floor_motion

contains

   !> Kinetic energy of the wall and of what is linked to it [J/kg].
   real(wp) function bent_kinetic_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u_s, u_s_dot
      real(wp), allocatable :: u(:), v(:)

      associate (beam => equation%beam, p => equation%p, q => y(equation%beam%first: &
                 equation%beam%first + equation%beam%n - 1), q_dot => y(equation%beam%first &
                 + equation%beam%n:equation%beam%first + 2*equation%beam%n - 1))
         energy = ((equation%inertia*p%R**2 - 2*equation%state%side*beam%half_width &
            *sum(beam%area*q) + sum(beam%mass*q**2))*y(2)**2 + sum(beam%mass*q_dot**2))/2 &
            + y(2)*sum(beam%arm*q_dot)
         if (allocated(beam%floors)) then
            call linked_floor_motion(equation, y, u, v)
            energy = energy + sum(beam%floors%m*v**2)/2
         else if (equation%has_frame) then
            call frame_motion(equation, equation%state%side, y, u_s, u_s_dot)
            energy = energy + p%gamma*u_s_dot**2/2
         end if
      end associate
   end function bent_kinetic_energy

   !> Strain energy of the frame of a single mass, or of linked floors [J/kg].
   real(wp) function bent_frame_strain(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u_s, u_s_dot
      real(wp), allocatable :: u(:), v(:)

      energy = 0
      if (allocated(equation%beam%floors)) then
         call linked_floor_motion(equation, y, u, v)
         energy = sum(equation%beam%floors%k*(u - [0.0_wp, u(:size(u) - 1)])**2)/2
      else if (equation%has_frame) then
         call frame_motion(equation, equation%state%side, y, u_s, u_s_dot)
         energy = equation%p%gamma*(equation%p%omega_s*u_s)**2/2
      end if
   end function bent_frame_strain

   !> Displacements and velocities of the floors that are linked to the wall one by one.
   subroutine linked_floor_motion(equation, y, u, v)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), allocatable, intent(out) :: u(:)
      !! (floors) relative to the ground [m]
      real(wp), allocatable, intent(out) :: v(:)
      !! (floors) [m/s]
      type(kinematics_t) :: kin
      real(wp), allocatable :: w(:), w_dot(:)

      kin = kinematics_of(equation%geometry, equation%state%side, equation%state%side*y(1))
      associate (beam => equation%beam, R => equation%p%R, side => equation%state%side)
         w = matmul(beam%floors%phi, y(beam%first:beam%first + beam%n - 1))
         w_dot = matmul(beam%floors%phi, y(beam%first + beam%n:beam%first + 2*beam%n - 1))
         u = beam%floors%share*(side*R*kin%u) + cos(y(1))*w
         v = (beam%floors%share*R*kin%j - sin(y(1))*w)*y(2) + cos(y(1))*w_dot
      end associate
   end subroutine linked_floor_motion

   !> Potential of the wall's weight that follows its modes [J/kg].
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

   !> Velocities after an impact. The impulse acts at the new corner: momenta that belong to turning
   !> about it and to each mode stay. With C = B M**-1 B, the coupling B of turning and modes and the
   !> mass matrix M of the modes, theta'+ = (H - C)/(I - C) theta'-; where that is not towards the
   !> new side, both corners stay on the base and the modes take all of the momentum.
   subroutine landing(equation, inertance, y, after, stays)
      type(equation_t), intent(in) :: equation
      !! on the side that the wall comes from
      real(wp), intent(in) :: inertance
      !! of the inerter under a corner over m_w [-]
      real(wp), intent(inout) :: y(:)
      !! (states) at theta = 0, theta' before the impact; those of the modes change
      real(wp), intent(inout) :: after
      !! theta' after the impact [rad/s]
      logical, intent(inout) :: stays
      !! both corners are kept on the base; on entry: whatever the momentum
      real(wp), dimension(equation%beam%n) :: coupling, taken
      real(wp) :: mass(equation%beam%n, equation%beam%n)
      real(wp) :: lean, inertia, momentum, shared
      integer :: i

      associate (beam => equation%beam, n => equation%beam%n, b => equation%beam%half_width, &
                 q => y(equation%beam%first:equation%beam%first + equation%beam%n - 1))
         lean = equation%state%side*sum(beam%area*q)
         momentum = equation%inertia*equation%p%R**2 - 2*b**2 + sum(beam%mass*q**2)
         coupling = beam%arm
         if (allocated(beam%floors)) then
            associate (floors => beam%floors)
               momentum = momentum + beam%length**2*sum(floors%m*floors%share**2)
               coupling = coupling + beam%length*matmul(floors%m*floors%share, floors%phi)
            end associate
         else
            momentum = momentum + equation%p%gamma*beam%length**2
            coupling = coupling + equation%p%gamma*beam%length
         end if
         ! the new corner is on the other side
         inertia = momentum + 2*b**2 + 2*b*lean + inertance*(2*b)**2
         mass = beam%linked_mass
         do i = 1, n
            mass(i, i) = mass(i, i) + beam%mass(i)
         end do
         taken = solution(mass, coupling)
         shared = dot_product(coupling, taken)
         after = (momentum - shared)/(inertia - shared)*y(2)
         if (.not. stays) stays = .not. (momentum - shared)*(inertia - shared) > 0
         if (stays) after = 0
         y(beam%first + n:beam%first + 2*n - 1) = y(beam%first + n:beam%first + 2*n - 1) &
            + taken*(y(2) - after)
      end associate
   end subroutine landing

   !> Solution of a symmetric, positive definite system, by Cholesky's factors.
   pure function solution(matrix, right) result(x)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(in) :: right(:)
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
