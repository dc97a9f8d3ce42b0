!> Motion of the floors and storeys of a frame whose floors have states, or are linked to a bending
!> wall one by one.
module rwmf_model_floor_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: frame_acceleration, frame_motion, model_t
   use rwmf_model_kinematics, only: kinematics_of, kinematics_t
   implicit none
   private

   public :: floor_motion, floor_accelerations, storey_motion, storey_accelerations
   public :: follows_roof

contains

   !> True if all floors move in a fixed proportion to the roof.
   pure logical function follows_roof(model)
      class(model_t), intent(in) :: model

      follows_roof = model%floors%n == 0 .and. .not. allocated(model%beam%floors)
   end function follows_roof

   !> Compute displacements and velocities of ground, floors and roof relative to the ground. If the
   !> floors follow the roof, only the roof has a place.
   pure subroutine floor_motion(model, side, y, u, v)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:)
      !! states
      real(wp), intent(out) :: u(0:)
      !! (0:n) [m]
      real(wp), intent(out) :: v(:)
      !! (n) [m/s]
      real(wp), dimension(size(v)) :: w, w_dot
      type(kinematics_t) :: kin

      u(0) = 0
      if (allocated(model%beam%floors)) then
         ! floors that are linked to a bending wall one by one
         kin = kinematics_of(model%geometry, side, side*y(1))
         associate (beam => model%beam, R => model%p%R)
            w = matmul(beam%floors%phi, y(beam%first:beam%first + beam%n - 1))
            w_dot = matmul(beam%floors%phi, y(beam%first + beam%n:beam%first + 2*beam%n - 1))
            u(1:) = beam%floors%share*(side*R*kin%u) + cos(y(1))*w
            v = (beam%floors%share*R*kin%j - sin(y(1))*w)*y(2) + cos(y(1))*w_dot
         end associate
         return
      end if
      associate (first => model%floors%first, n => model%floors%free)
         u(1:n) = y(first:first + n - 1)
         v(:n) = y(first + n:first + 2*n - 1)
         if (n < size(v)) call frame_motion(model, side, y, u(n + 1), v(n + 1))
      end associate
   end subroutine floor_motion

   !> Compute the displacements of the storeys and their rates.
   pure subroutine storey_motion(model, side, y, d, d_dot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: d(:)
      !! (n) u_i - u_(i-1) [m]
      real(wp), intent(out) :: d_dot(:)
      !! (n) [m/s]
      real(wp) :: u(0:size(d))
      real(wp) :: v(size(d))
      integer :: n

      n = size(d)
      call floor_motion(model, side, y, u, v)
      d = u(1:) - u(:n - 1)
      d_dot = v
      d_dot(2:) = v(2:) - v(:n - 1)
   end subroutine storey_motion

   !> Accelerations of the floors relative to the ground.
   pure function floor_accelerations(model, side, y, y_dot) result(u_ddot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) states and their rates
      real(wp) :: u_ddot(model%floors%n_storeys)
      !! [m/s2]
      real(wp), dimension(size(u_ddot)) :: w, w_dot, w_ddot
      type(kinematics_t) :: kin

      if (allocated(model%beam%floors)) then
         ! floors that are linked to a bending wall one by one
         kin = kinematics_of(model%geometry, side, side*y(1))
         associate (beam => model%beam, R => model%p%R, n => model%beam%n, &
                    first => model%beam%first, sine => sin(y(1)), cosine => cos(y(1)))
            w = matmul(beam%floors%phi, y(first:first + n - 1))
            w_dot = matmul(beam%floors%phi, y(first + n:first + 2*n - 1))
            w_ddot = matmul(beam%floors%phi, y_dot(first + n:first + 2*n - 1))
            u_ddot = beam%floors%share*R*(side*kin%k*y(2)**2 + kin%j*y_dot(2)) &
               + cosine*(w_ddot - w*y(2)**2) - sine*(2*w_dot*y(2) + w*y_dot(2))
         end associate
         return
      end if
      associate (first => model%floors%first, n => model%floors%free)
         u_ddot(:n) = y_dot(first + n:first + 2*n - 1)
         if (n < size(u_ddot)) u_ddot(n + 1) = frame_acceleration(model, side, y, y_dot)
      end associate
   end function floor_accelerations

   !> Second derivatives of the displacements of the storeys.
   pure function storey_accelerations(model, side, y, y_dot) result(d_ddot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) states and their rates
      real(wp) :: d_ddot(model%floors%n_storeys)
      !! [m/s2]

      d_ddot = floor_accelerations(model, side, y, y_dot)
      d_ddot(2:) = d_ddot(2:) - d_ddot(:size(d_ddot) - 1)
   end function storey_accelerations

end module rwmf_model_floor_motion
