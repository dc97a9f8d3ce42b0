!> Design demands of a building at one instant: floor drifts and accelerations, storey shears,
!> overturning moment, and section forces of the wall.
!>
!> A frame with all modes has states for each floor. A frame with one mode, or with links to every
!> floor, follows its shape instead. Floor i then has the share phi_i/phi_n of the roof's
!> displacement. Its absolute acceleration is the ground acceleration plus that share of the roof's
!> relative acceleration. A single degree of freedom is one floor without a storey.
module rwmf_model_system_demands
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_beam, only: link_deflections, tip_deflection
   use rwmf_model_bent_wall, only: bent_overturning
   use rwmf_model_effects_p_delta, only: leaning_height, leaning_loads
   use rwmf_model_equation, only: equation_t, frame_acceleration, frame_displacement, frame_mass, &
      frame_motion, ground, kinematics_at
   use rwmf_model_floor_motion, only: floor_accelerations, floor_motion, follows_roof
   use rwmf_model_floors_floor_forces, only: column_shears, forces_of_linked_floors, link_pulls
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_force
   use rwmf_model_hysteresis_spring_laws, only: spring_force
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_system_bent_sections, only: bent_sections_t, create_bent_sections, &
      find_bent_extremes
   use rwmf_model_system_reactions, only: link_force, link_tilt, plastic_part, roof_acceleration
   use rwmf_model_system_wall_sections, only: find_section_extremes, link_places, links_t, &
      section_extremes_t
   use rwmf_problem_case, only: case_t, has_floors
   use rwmf_problem_frame_strength, only: has_strength
   use rwmf_problem_scene_axes, only: share_frame
   implicit none
   private

   public :: building_t, demands_t, building_of, demands_at, links_of
   public :: floor_count, lowest_link

   !> Building data for the demands, in addition to the equation of motion.
   type :: building_t
      integer :: floors = 0
      !! number of floors, 0 without a frame
      integer :: drifts = 0
      !! number of storeys, each with one drift; 0 for a single degree of freedom
      real(wp) :: roof_height = 0
      !! height of the wall, or of the frame without a wall; 0 if unknown [m]
      real(wp) :: unit = 1
      !! reference mass of the floors with states, over the unit of m [-]
      real(wp) :: weight = 0
      !! weight of wall and floors over the unit of m [m/s2]
      real(wp) :: viscous_time = 0
      !! 2 xi_s/omega_s, damping over stiffness of storeys that follow the roof [s]
      logical :: is_linear = .true.
      !! storeys do not yield
      logical :: has_sections = .true.
      !! the largest shear and moment along the wall are requested
      real(wp), allocatable :: m(:)
      !! (floors) mass over m_w; without a wall in the mass unit of the case [-]
      real(wp), allocatable :: z(:)
      !! (floors) height above the ground [m]; not allocated if unknown
      real(wp), allocatable :: share(:)
      !! (floors) share of the roof's displacement, where floors follow the roof [-]
      real(wp), allocatable :: height(:)
      !! (storeys) [m]
      real(wp), allocatable :: bend(:)
      !! (storeys) storey displacement over the roof's displacement [-]
      real(wp), allocatable :: k(:)
      !! (storeys) stiffness over the unit of m [1/s2]
      real(wp), allocatable :: load(:)
      !! (storeys) P-Delta force of the leaning loads per storey displacement, over the same unit
      !! [1/s2]
      type(bent_sections_t), allocatable :: sections
      !! sections of a bending wall
   end type building_t

   !> Demands at one instant, with their signs.
   type :: demands_t
      real(wp), allocatable :: drift(:)
      !! (storeys) storey displacement over its height [-]
      real(wp), allocatable :: acceleration(:)
      !! (floors) absolute acceleration [m/s2]
      real(wp), allocatable :: shear(:)
      !! (storeys) shear of the columns without dampers, over the unit of m [m/s2]
      real(wp) :: overturning = 0
      !! moment of the horizontal inertia forces about the ground, over the weight [m]
      type(section_extremes_t) :: wall
      !! largest section forces of the wall
      type(links_t) :: links
      !! link forces that cause the section forces
   end type demands_t

contains

   !> Number of floors of a case; 1 for a single degree of freedom.
   pure integer function floor_count(case)
      type(case_t), intent(in) :: case

      floor_count = 1
      if (has_floors(case)) floor_count = size(case%frame%floors%m)
   end function floor_count

   !> Number of the lowest floor with a link: the roof, unless every floor has one.
   pure integer function lowest_link(case)
      type(case_t), intent(in) :: case

      lowest_link = floor_count(case)
      if (.not. has_floors(case)) return
      associate (coupling => case%frame%coupling)
         if (coupling == 'every_floor' .or. coupling == 'springs') lowest_link = 1
      end associate
   end function lowest_link

   !> Collect the building data of a case. Several walls have one wall's part of the frame each.
   subroutine building_of(case, equation, building)
      type(case_t), intent(in) :: case
      !! with the frame's T_s
      type(equation_t), intent(in) :: equation
      !! of this case
      type(building_t), intent(out) :: building
      type(case_t) :: shared

      if (equation%walls == 1) then
         call describe_building(case, equation, building)
      else
         shared%structure_t = case%structure_t
         call share_frame(shared)
         call describe_building(shared, equation, building)
      end if
   end subroutine building_of

   !> Collect the building data of one wall and its part of the frame.
   subroutine describe_building(case, equation, building)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(building_t), intent(out) :: building

      if (equation%has_wall) then
         building%weight = equation%p%g
         building%roof_height = 2*case%wall%h
      end if
      allocate (building%height(0), building%bend(0), building%k(0), building%load(0))
      if (.not. equation%has_frame) then
         if (equation%beam%n > 0) then
            allocate (building%sections)
            call create_bent_sections(building%sections, equation%beam, [real(wp) ::])
         end if
         return
      end if
      if (has_floors(case)) then
         call describe_storeys(case, equation, building)
      else
         building%floors = 1
         building%m = [frame_mass(equation)]
         building%share = [1.0_wp]
         if (.not. equation%has_wall) building%roof_height = leaning_height(case)
         if (building%roof_height > 0) building%z = [building%roof_height]
      end if
      building%weight = building%weight + equation%p%g*sum(building%m)
      if (equation%beam%n == 0) return
      allocate (building%sections)
      call create_bent_sections(building%sections, equation%beam, building%z)
   end subroutine describe_building

   !> Describe a frame of storeys. In a spectrum all stiffnesses follow the period.
   subroutine describe_storeys(case, equation, building)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(building_t), intent(inout) :: building
      integer :: n, i

      associate (frame => case%frame%floors)
         n = size(frame%m)
         building%floors = n
         building%drifts = n
         building%m = frame%m
         building%height = frame%height
         building%z = [(sum(frame%height(:i)), i=1, n)]
         if (.not. equation%has_wall) building%roof_height = building%z(n)
         building%share = frame%shape(:, 1)/frame%shape(n, 1)
         building%bend = building%share - [0.0_wp, building%share(:n - 1)]
         building%k = frame%k*(2*pi/case%frame%T_s/frame%omega(1))**2
         building%load = leaning_loads(case)
         building%viscous_time = case%frame%xi_s*case%frame%T_s/pi
         building%is_linear = .not. has_strength(case)
         building%unit = equation%floors%unit
      end associate
   end subroutine describe_storeys

   !> Compute the demands at a state of motion. For a wall at rest, pass zeros for its motion.
   subroutine demands_at(building, equation, t, y, y_dot, demands)
      type(building_t), intent(inout) :: building
      !! its section forces change
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) rates of the states
      type(demands_t), intent(inout) :: demands
      real(wp) :: u_ddot(building%floors)
      !! accelerations of the floors relative to the ground [m/s2]
      real(wp) :: a

      a = ground(equation, t)
      call follow_floors(building, equation, y, y_dot, demands, u_ddot)
      demands%acceleration = u_ddot + a
      demands%overturning = 0
      if (allocated(building%z)) demands%overturning = sum(building%m*building%z &
         *demands%acceleration)
      if (equation%has_wall) then
         if (equation%beam%n > 0) then
            demands%overturning = demands%overturning + bent_overturning(equation, a, y, y_dot)
         else
            demands%overturning = demands%overturning + wall_overturning(equation, a, y, y_dot(2))
         end if
      end if
      demands%overturning = demands%overturning/building%weight
      if (.not. (equation%has_wall .and. building%has_sections)) return
      call links_of(building, equation, kinematics_at(equation, y(1)), t, y, y_dot, demands%links)
      if (equation%beam%n > 0) then
         call find_bent_extremes(building%sections, equation, t, y, y_dot, demands%links, &
            demands%wall)
      else
         call find_section_extremes(equation, t, y, y_dot(2), demands%links, demands%wall)
      end if
   end subroutine demands_at

   !> Compute the relative accelerations of the floors, and the drifts and shears of the storeys.
   subroutine follow_floors(building, equation, y, y_dot, demands, u_ddot)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      type(demands_t), intent(inout) :: demands
      real(wp), intent(out) :: u_ddot(:)
      !! (floors) [m/s2]
      real(wp) :: u(0:building%floors), v(building%floors)

      if (.not. equation%has_frame) then
         demands%drift = u_ddot
         demands%shear = u_ddot
         return
      end if
      associate (n => building%floors)
         if (.not. follows_roof(equation)) then
            u_ddot = floor_accelerations(equation, equation%state%side, y, y_dot)
            call floor_motion(equation, equation%state%side, y, u, v)
            demands%shear = equation%floors%unit*column_shears(equation, y)
         else
            u_ddot = building%share*frame_acceleration(equation, equation%state%side, y, y_dot)
            u(0) = 0
            u(1:) = building%share*frame_displacement(equation, equation%state%side, y)
            demands%shear = building%k*building%bend*resisting_displacements(building, equation, y)
         end if
         ! those of the whole frame
         demands%shear = equation%walls*demands%shear
         demands%drift = u(1:building%drifts) - u(0:building%drifts - 1)
         demands%drift = demands%drift/building%height
      end associate
   end subroutine follow_floors

   !> Roof displacement at which elastic storeys would carry the present force of each storey [m].
   !> All values are equal where the storeys yield together.
   function resisting_displacements(building, equation, y) result(u)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: u(building%drifts)
      real(wp) :: roof
      integer :: i, n

      roof = frame_displacement(equation, equation%state%side, y)
      u = roof
      if (equation%floors%yields) then
         u = roof - plastic_part(equation, y)
      else if (equation%has_loading_direction) then
         u = bouc_wen_force(equation, y)/equation%p%omega_squared
      else if (allocated(equation%springs)) then
         n = count(equation%springs%element == 0)
         do i = 1, n
            associate (spring => equation%springs(i))
               u(i) = spring_force(spring%spring, equation%state%springs(i), roof) &
                  /(spring%share*equation%p%omega_squared)
            end associate
         end do
         if (n == 1) u = u(1)
      end if
   end function resisting_displacements

   !> Compute the forces of the links on the wall.
   !>
   !> Link springs have the forces of their elongations. With rigid links at every floor, each link
   !> force balances the inertia of its floor and the difference of the storey forces above and
   !> below. The storey forces include shears and storey dampers, less the P-Delta force of leaning
   !> loads.
   subroutine links_of(building, equation, kin, t, y, y_dot, links)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      !! with a wall
      type(kinematics_t), intent(in) :: kin
      !! at this rotation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      type(links_t), intent(inout) :: links
      !! arrays that are already allocated are reused
      real(wp), dimension(building%drifts) :: shear, a
      real(wp) :: u, v
      integer :: i, n

      n = min(1, building%floors)
      if (equation%floors%are_linked) n = building%floors
      if (.not. allocated(links%place)) allocate (links%place(2, n), links%force(2, n))
      if (.not. equation%floors%are_linked) then
         links%place(:, :) = link_places(equation, [(1.0_wp, i=1, n)])
         if (equation%beam%n > 0) links%place(1, :) = links%place(1, :) &
            + tip_deflection(equation%beam, y)
         if (building%floors > 0) links%force(:, 1) = link_force(equation, kin, t, y, y_dot)
         return
      else if (allocated(equation%beam%floors)) then
         associate (beam => equation%beam)
            links%place(:, :) = link_places(equation, beam%floors%share)
            links%place(1, :) = links%place(1, :) + matmul(beam%floors%phi, y(beam%first: &
               beam%first + beam%n - 1))
         end associate
         links%force(1, :) = forces_of_linked_floors(equation, t, y, y_dot)
         links%force(2, :) = 0
         return
      end if
      if (allocated(equation%floors%k_link)) then
         links%place(:, :) = link_places(equation, equation%floors%share)
         if (equation%beam%n > 0) links%place(1, :) = links%place(1, :) &
            + link_deflections(equation%beam, y)
         links%force(1, :) = -link_pulls(equation, y)
         links%force(2, :) = 0
         return
      end if
      call frame_motion(equation, equation%state%side, y, u, v)
      shear = building%bend*(building%k*(resisting_displacements(building, equation, y) &
         + building%viscous_time*v) - building%load*u)
      a = building%share*roof_acceleration(equation, kin, y, y_dot) + ground(equation, t)
      links%place(:, :) = link_places(equation, building%share)
      links%force(1, :) = -building%m*a - shear
      links%force(1, :n - 1) = links%force(1, :n - 1) + shear(2:)
      links%force(2, :) = link_tilt(equation, kin)*links%force(1, :)
   end subroutine links_of

   !> Moment of the wall's horizontal inertia about the ground over m_w [m2/s2]. It has a part from
   !> the acceleration of the centroid and one from the rotation about it.
   pure real(wp) function wall_overturning(equation, ground_acceleration, y, y_ddot) result(moment)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: ground_acceleration
      !! [m/s2]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      real(wp) :: h, b, arm, sine, cosine, height, push

      h = equation%p%R*equation%p%cos_alpha
      b = equation%p%R*equation%p%sin_alpha
      ! distance from the axis to the pivot
      arm = equation%state%side*equation%p%R*equation%geometry%sine_wall
      sine = sin(y(1))
      cosine = cos(y(1))
      height = h*cosine + arm*sine
      push = ground_acceleration + height*y_ddot + (arm*cosine - h*sine)*y(2)**2
      moment = push*height + (y_ddot*(b**2*sine**2 + h**2*cosine**2) &
         - y(2)**2*(h**2 - b**2)*sine*cosine)/3
   end function wall_overturning

end module rwmf_model_system_demands
